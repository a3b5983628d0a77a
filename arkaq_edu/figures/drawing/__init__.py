"""What all figures share: the visual grammar, diagrams, animations."""
