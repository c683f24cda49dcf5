"""Declarations to modelDescription.xml and documentation."""
