"""No more model than a scene needs: the ladder of models, what is asked of them, and the choice."""
