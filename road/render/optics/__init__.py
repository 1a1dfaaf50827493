"""From the pinhole image of a scene to recorded pixels: motion, lens, weather in the air, sensor."""
