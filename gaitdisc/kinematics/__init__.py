"""From markers to the body's motion: marker sets, joint centres, segments in space, joint angles."""
