"""Other programs beside ours: the same problems on meshes from coarse to fine, error against processor time."""
