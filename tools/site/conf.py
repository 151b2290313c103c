"""Sphinx's settings for the site of the documentation; tools/site/build.py stages the pages."""

project = "relume"
html_title = "relume"
extensions = ["myst_parser"]
root_doc = "index"

html_theme = "theme"
html_theme_path = ["."]
html_copy_source = False
html_use_index = False
smartquotes = False
highlight_language = "text"

# Anchors as on GitHub. The rest of MyST's syntax is not used: {name} and % in a text must stay as they are.
myst_heading_anchors = 6
myst_disable_syntax = ["myst_role", "myst_target", "myst_line_comment", "myst_block_break"]
