"""What people read: wording and numbers, charts, and the page of a test."""
