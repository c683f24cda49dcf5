"""FMUs from components: model description, export, files in fmus/dist/."""
