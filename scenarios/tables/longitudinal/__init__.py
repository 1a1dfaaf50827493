"""Studies of braking: speed planned for comfort, and stopping on rough roads."""
