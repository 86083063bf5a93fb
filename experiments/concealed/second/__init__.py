"""Set 2 of the concealed test cases: many robots, small mismatch in every case."""
