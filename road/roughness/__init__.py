"""Road roughness: random profiles by ISO 8608, the class of a given profile, and the IRI."""
