import numpy as np
import pytest

from gaitdisc.errors import TrainingError
from gaitdisc.sensing.latent_states import latent_states
from gaitdisc.sensing.reconstructor import fit_reconstructor


@pytest.mark.parametrize("kind", ["shred", "shred-text"])
def test_the_latent_state_decoded_is_what_the_model_estimates(pair, untrained, kind):
    done, windows = untrained(kind), pair.parts.tested()
    latent = latent_states(done, windows)
    assert latent.shape == (len(windows), 64)
    np.testing.assert_allclose(done.model.decoded(latent), done(windows), rtol=1e-5, atol=1e-5)


def test_a_model_without_a_recurrent_network_has_no_latent_state(pair):
    ridge = fit_reconstructor("delay ridge", pair.what, pair.parts.fitted(), pair.parts.checked())
    with pytest.raises(TrainingError, match="the model is 'delay ridge', which has none"):
        latent_states(ridge, pair.parts.tested())
