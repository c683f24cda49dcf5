"""The co-simulation core: drives any FMI 2.0 co-simulation FMU. It knows an FMU by its model description and the FMI calls only."""
