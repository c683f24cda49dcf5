"""FMUs from components: model description, export, the folder of built FMUs."""
