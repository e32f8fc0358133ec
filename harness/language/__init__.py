"""The scenario language: files with positions, models, units, parameters and located mistakes."""
