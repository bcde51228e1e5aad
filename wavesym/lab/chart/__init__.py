"""Speed against accuracy: what is compared on a scene, what errors are measured from, and the picture."""
