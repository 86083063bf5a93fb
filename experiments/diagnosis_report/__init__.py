"""What a diagnosis shows: its page, its pictures, its ten lines and its overlay."""
