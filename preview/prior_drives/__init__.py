"""Prior knowledge of a road: maps, and the memory that an earlier drive left."""
