"""`wavesym report`: one page of HTML that shows a scene and what becomes of it, with pictures of its own making."""
