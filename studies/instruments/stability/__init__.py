"""Where methods fail: one file a family of failures, each with what theory says and what was measured."""
