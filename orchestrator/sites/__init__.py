"""Sites: data of a slope or a pile, checked, and turned into components that can be computed."""
