"""stub"""
def write_suite_page(path, plan, results, summaries, settings):
    path.write_text("")
    return path
