"""The mixed element: strain operator, element matrices, sparsity. No strain measure, load or support by name."""
