"""What a person looks at: tables, figures and films of runs."""
