"""What is made of raw channels before anything is fitted: filters, derivatives, strides, quality."""
