"""Chapter 3: the two error signals of a model against measurements, what is fitted to them, and what comes of it."""
