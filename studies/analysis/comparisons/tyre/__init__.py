"""What the force and the patch of the tyre are worth: beside print, beside a solid, and error by error."""
