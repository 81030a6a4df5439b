"""The methods: error against cost, where they fail, how large a model must be, published numbers."""
