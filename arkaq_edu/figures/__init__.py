"""One function for each figure of the thesis, and the visual grammar they share."""
