"""Wave matching: soil resistance, quakes and damping from a measured blow."""
