"""What a language model needs to work with scenarios: a skill, and a scene as data."""
