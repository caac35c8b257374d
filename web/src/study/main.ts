// The participant's page.

import '../style.css';
import { element } from '../dom';

document.getElementById('app')!.replaceChildren(element('main', { class: 'page' }, 'The study opens.'));
