"""Networks and the one trainer of all of them; the only home of torch."""
