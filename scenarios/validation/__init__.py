"""Every number foreride rests on, held against something that is not foreride: `foreride validation`."""
