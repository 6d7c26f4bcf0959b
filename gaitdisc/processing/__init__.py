"""From the files of a trial to a filtered, stride-cut walk."""
