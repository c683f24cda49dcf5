"""Reports that a reviewer can check: one HTML page that needs no network, and a PDF."""
