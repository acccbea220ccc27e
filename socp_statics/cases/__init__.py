"""Problem files in, records out: here a verdict, a region and a certificate become one answer."""
