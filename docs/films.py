"""Films in the gallery: each animation of an example becomes a GIF, which needs no script and no network."""

import matplotlib.pyplot as plt
from matplotlib.animation import Animation
from sphinx_gallery.scrapers import figure_rst


def _get_sg_image_scraper():
    return films


def films(block, block_vars, gallery_conf):
    """Save the open animations of a block and close their figures, before matplotlib's scraper sees them."""
    paths = []
    for film in block_vars["example_globals"].values():
        if isinstance(film, Animation) and plt.fignum_exists(film._fig.number):
            paths.append(block_vars["image_path_iterator"].next().replace(".png", ".gif"))
            film.save(paths[-1], writer="pillow")
            plt.close(film._fig)
    return figure_rst(paths, gallery_conf["src_dir"])
