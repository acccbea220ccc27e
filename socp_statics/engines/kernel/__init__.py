"""The toolkit's own engine: dense second-order cone programs of a few variables, compiled by Numba on first use."""
