"""The order of the gallery, and its films: an animation becomes a GIF, which needs no script."""

from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.animation import Animation
from sphinx_gallery.scrapers import figure_rst
from sphinx_gallery.sorting import FileNameSortKey

ORDER = """first_graze p4_and_its_hysteresis whole_branch one_collision bands_of_the_map strange_attractor
coming_to_rest two_stops contact_laws peak_force mode_shapes matrices_of_your_own modal_test
fit_a_record missed_touches""".split()


class ReadingOrder(FileNameSortKey):
    """The examples in the order in which a reader may take them."""

    def __call__(self, filename):
        return ORDER.index(Path(filename).stem)


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
