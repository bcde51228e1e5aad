"""What the stages of the compiler make of a scene, for a reader: `document.inspection`."""
