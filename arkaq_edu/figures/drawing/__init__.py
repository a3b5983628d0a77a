"""What all figures share: the plot they return, the visual grammar, diagrams, animations."""
