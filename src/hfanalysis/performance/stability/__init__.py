"""Whether it burnt smoothly: roughness, the lines of the spectrum, and what each of them can be."""
