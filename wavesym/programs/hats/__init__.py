"""The march of one hat of each record, whatever the spacing of its samples."""
