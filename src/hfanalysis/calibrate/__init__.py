"""What a test says about its tank, feed line and injector: C_i, K_loss, Z and m with their uncertainties."""
