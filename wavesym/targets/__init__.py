"""Program -> files: a folder for each language, and the manifest. Other rooms ask files.py."""
