"""How meshes become convex parts."""
