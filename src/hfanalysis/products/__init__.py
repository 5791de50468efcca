"""What every stage writes: the content of each product, and how products are kept on disk."""
