"""What all of geomkin uses: errors, validation, names, reprs, progress, processes."""
